"""Parts of every page, figure and terminal table: style, numbers, tables, progress."""
