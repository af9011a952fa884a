halcompile --compile gates2.comp 2>/dev/null
hal describe gates2 personality=0x103
