"""What is simulated: slider, loading, initial state; quantities, units, and arrays of them."""
