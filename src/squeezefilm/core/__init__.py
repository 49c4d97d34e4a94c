"""What every part stands on: quantities, errors, configuration, results, files, the report kit."""
