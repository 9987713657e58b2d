"""What the likelihood says of each estimate: profiles, posterior, intervals."""
