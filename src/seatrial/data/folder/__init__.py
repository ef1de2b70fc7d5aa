"""Result folders: model file, result, arrays and tables, written and read."""
