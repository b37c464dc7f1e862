//! roberval-linalg
