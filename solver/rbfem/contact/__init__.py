"""Who touches whom and with what force."""
