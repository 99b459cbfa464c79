"""Shared by all tests."""

from hypothesis import HealthCheck, settings

# Slow shared machines must not fail a property; the same examples every time keep a red test red.
settings.register_profile("saddleback", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("saddleback")
