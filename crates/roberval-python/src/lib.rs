//! roberval-python
