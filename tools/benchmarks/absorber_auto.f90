! P_2^1 of the reduced absorber written l/2 times, for AUTO-07p: 2 l algebraic equations (IPS = 0), parameter C = PAR(1).
! Unknowns Psi_i, B_i on the walls L, R, L, R, ...; constants of the machine as in case.py.

      SUBROUTINE FUNC(NDIM,U,ICP,PAR,IJAC,F,DFDU,DFDP)
      IMPLICIT NONE
      INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
      DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)
      DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
      DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM,NDIM), DFDP(NDIM,*)
      DOUBLE PRECISION, PARAMETER :: R = 0.76D0, A = 1.006D0*0.5D0*0.211D0, PI = 3.14159265358979323846D0
      DOUBLE PRECISION :: C, S, D, V, PULL, S0, C0, S1, C1, PSI1
      INTEGER :: I, L, J, K

      C = PAR(1)
      L = NDIM/2
      IF (IJAC > 0) DFDU = 0D0
      DO I = 1, L
        J = 2*I - 1
        K = J + 2
        PSI1 = 0D0
        IF (I == L) THEN
          K = 1
          PSI1 = PI*L
        END IF
        S = 1D0
        IF (MOD(I,2) == 1) S = -1D0
        PSI1 = PSI1 + U(K)
        D = PSI1 - U(J)
        S0 = SIN(U(J))
        C0 = COS(U(J))
        S1 = SIN(PSI1)
        C1 = COS(PSI1)
        PULL = U(J+1) + S*A*D
        V = C*C1 - PULL
        F(J) = U(K+1) - C*C1 - R*V
        F(J+1) = -2D0*S + C*(S1 - S0) - (U(J+1) + 0.5D0*S*A*D)*D
        IF (IJAC > 0) THEN
          DFDU(J,J) = DFDU(J,J) - R*S*A
          DFDU(J,J+1) = DFDU(J,J+1) + R
          DFDU(J+1,J) = DFDU(J+1,J) + PULL - C*C0
          DFDU(J+1,J+1) = DFDU(J+1,J+1) - D
          DFDU(J,K) = DFDU(J,K) + (1D0 + R)*C*S1 + R*S*A
          DFDU(J,K+1) = DFDU(J,K+1) + 1D0
          DFDU(J+1,K) = DFDU(J+1,K) + V
        END IF
        IF (IJAC > 1) THEN
          DFDP(J,1) = -(1D0 + R)*C1
          DFDP(J+1,1) = S1 - S0
        END IF
      END DO
      END SUBROUTINE FUNC

      SUBROUTINE STPNT(NDIM,U,PAR,T)
      IMPLICIT NONE
      INTEGER, INTENT(IN) :: NDIM
      DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)
      DOUBLE PRECISION, INTENT(IN) :: T
      DOUBLE PRECISION, PARAMETER :: R = 0.76D0, A = 1.006D0*0.5D0*0.211D0, PI = 3.14159265358979323846D0
      DOUBLE PRECISION, PARAMETER :: BETA = 0.65D0
      DOUBLE PRECISION :: SINE, COSINE
      INTEGER :: I

      SINE = 1D0 - 0.5D0*PI*BETA
      COSINE = (1D0 - R)/(1D0 + R)*BETA + 0.5D0*PI*A
      PAR(1) = SQRT(SINE**2 + COSINE**2)
      DO I = 1, NDIM/2
        U(2*I-1) = ATAN2(SINE, COSINE) + PI*(I - 1)
        U(2*I) = BETA + 0.5D0*PI*A
        IF (MOD(I,2) == 0) U(2*I) = -U(2*I)
      END DO
      END SUBROUTINE STPNT

      SUBROUTINE BCND
      END SUBROUTINE BCND

      SUBROUTINE ICND
      END SUBROUTINE ICND

      SUBROUTINE FOPT
      END SUBROUTINE FOPT

      SUBROUTINE PVLS
      END SUBROUTINE PVLS
