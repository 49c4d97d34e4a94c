"""What every page, figure and terminal table is made with: style, numbers, tables, progress."""
