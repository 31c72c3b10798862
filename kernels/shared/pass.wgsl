// Which of a kernel's two runs it is: 0 or 1.

struct Pass { index: u32 }
