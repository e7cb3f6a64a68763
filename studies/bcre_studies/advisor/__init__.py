"""What ``bcre advise`` does: the cheapest model that answers a scene."""
