//! The methods: each a page of calls to stages.
