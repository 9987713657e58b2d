"""Find segments of constant speed, holds and steps of normal stress in a record."""
