#include "plan.h"
int plan_program(struct job *j) { (void)j; return 70; }
