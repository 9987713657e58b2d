"""The slider and its loading, with their quantities, units and messages."""
