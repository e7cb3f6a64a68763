"""Measuring tools for speed: a clock, the machine itself, and what a user would pick instead."""
