"""Laboratory records: read, and fitted."""
