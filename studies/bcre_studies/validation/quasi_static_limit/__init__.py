"""When does a scene need no rolling layer?"""
