"""What a fit says in words: what is determined, what is doubtful, which law is preferred."""
