/* Call a gravity torque written by Isotorque: joint angles in, torques out.
 *
 *     isotorque derive 2r --c gravity.c
 *     cc -O2 call_gravity.c gravity.c -lm -o call_gravity
 *     ./call_gravity 0.1 -0.5
 *
 * prints the torques [N m] that hold the arm at the angles [rad] given, one per line.
 */
#include <stdio.h>
#include <stdlib.h>

void isotorque_gravity(const double *q, double *tau);

int main(int argc, char **argv)
{
    enum { MOST = 64 };
    double q[MOST], tau[MOST];
    const int n = argc - 1;
    if (n < 1 || n > MOST) {
        fprintf(stderr, "usage: %s q1 q2 ...\n", argv[0]);
        return 2;
    }
    for (int i = 0; i < n; i++) {
        char *end;
        q[i] = strtod(argv[i + 1], &end);
        if (end == argv[i + 1] || *end != '\0') {
            fprintf(stderr, "error: '%s' is not an angle [rad]\n", argv[i + 1]);
            return 2;
        }
    }
    isotorque_gravity(q, tau);
    for (int i = 0; i < n; i++)
        printf("%.17g\n", tau[i]);
    return 0;
}
