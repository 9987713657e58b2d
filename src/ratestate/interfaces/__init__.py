"""Ways in besides Python: the command line, and the function `explore`."""
