"""Adapters for other packages, one module each.

Nothing here is imported with ``anastomesh``: each module needs its package, which the extra of the same name installs.
"""
