"""Conditioning of recordings: clocks, filters, derivatives, decimation."""
