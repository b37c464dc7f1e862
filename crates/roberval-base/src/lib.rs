//! roberval-base
