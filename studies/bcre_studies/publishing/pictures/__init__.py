"""The report's own pictures: what the answer looks like, in one picture and in three."""
