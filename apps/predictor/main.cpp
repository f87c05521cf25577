#include <cstdio>
int main() { std::puts("predictor"); }
