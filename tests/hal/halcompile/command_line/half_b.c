int half_b(void) { return 22; }
