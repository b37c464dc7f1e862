//! roberval-formats
