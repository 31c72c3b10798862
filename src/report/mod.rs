//! What is reported about a picture: error metrics and image files.
