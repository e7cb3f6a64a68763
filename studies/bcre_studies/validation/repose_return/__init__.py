"""Study: does a slope return to the angle of repose?"""
