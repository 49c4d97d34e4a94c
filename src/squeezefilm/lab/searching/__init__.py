"""What the Search area asks for: requirements read and checked, a search in its own process."""
