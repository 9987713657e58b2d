"""Motion under any loading, step by step."""
