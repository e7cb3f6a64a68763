"""Heaps on a free surface: which flow rules keep them round?"""
