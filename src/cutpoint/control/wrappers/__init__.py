"""Around any law: guards, observers and filters."""
