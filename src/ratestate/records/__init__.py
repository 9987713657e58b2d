"""Laboratory records: read, fitted and evaluated; `kit` is what the evaluations share."""
