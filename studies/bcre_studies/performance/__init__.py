"""Speed against error, scaling, what a scene needs, and the rivals."""
