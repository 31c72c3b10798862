// Which of a kernel's runs it is, or, where a kernel keeps what it found for a later run, of how many items
// it does.

struct Pass { index: u32 }
