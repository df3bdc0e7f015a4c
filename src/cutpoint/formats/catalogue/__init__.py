"""The catalogue of drives that comes with the package."""
