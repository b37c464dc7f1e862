//! roberval-regressor
