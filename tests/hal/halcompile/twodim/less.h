typedef struct less struct_less;
