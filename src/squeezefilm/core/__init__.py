"""Ground of every part: quantities, errors, configuration, results, files, the report kit."""
