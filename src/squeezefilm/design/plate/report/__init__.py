"""Output of `plate` for plates, discs and rings: page, figures, tables, volume for ParaView."""
