"""What `plate` shows of plates, discs and rings: page, figures, tables, volume for ParaView."""
