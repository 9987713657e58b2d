"""Ways in beside Python: scenario files, the command line, the explorer."""
