"""Hypothesis without a deadline: the time of one example says nothing on a shared machine."""

from hypothesis import settings

settings.register_profile("contact", deadline=None)
settings.load_profile("contact")
