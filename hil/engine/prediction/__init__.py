"""A plan on the model of the bench, without the wire: forecasts, searches, campaigns."""
