"""Files of a result folder: model, result, arrays."""
