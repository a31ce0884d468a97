//! Against others: closed forms, other programs, published values.

mod photometry;
