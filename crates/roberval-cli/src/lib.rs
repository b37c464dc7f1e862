//! roberval-cli
