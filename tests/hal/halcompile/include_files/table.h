#define TABLE_SIZE 16
typedef struct {
  int a, b;
} struct_of_mine;
static const double table[] = {0, 1, 2, 3.5};
