"""Does what ``bcre advise`` advises reach the tolerance, at the least cost?"""
