pin in bit a;
