"""Reports: pages of prose, tables and pictures, as one HTML file, as JSON, and in the terminal; progress bars."""
