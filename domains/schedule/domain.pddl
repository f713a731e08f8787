; Machines that shape, bore, smooth and paint parts: predicates and actions of the competitions'
; domain of this name.
(define (domain schedule)
  (:requirements :adl :typing)
  (:types temperature-type ashape surface machine part colour width anorient)
  (:constants
    cold hot - temperature-type  cylindrical - ashape  polished rough smooth - surface
    polisher roller lathe grinder punch drill-press spray-painter immersion-painter - machine)
  (:predicates
    (temperature ?x - part ?t - temperature-type) (busy ?m - machine) (scheduled ?x - part)
    (objscheduled) (surface-condition ?x - part ?s - surface) (shape ?x - part ?s - ashape)
    (painted ?x - part ?c - colour) (has-hole ?x - part ?w - width ?o - anorient)
    (has-bit ?m - machine ?w - width) (can-orient ?m - machine ?o - anorient)
    (has-paint ?m - machine ?c - colour))
  (:action do-polish
    :parameters (?x - part)
    :precondition (and (not (busy polisher)) (not (scheduled ?x)) (temperature ?x cold))
    :effect (and (busy polisher) (scheduled ?x) (objscheduled) (surface-condition ?x polished)
      (forall (?s - surface)
        (when (not (= ?s polished)) (not (surface-condition ?x ?s))))))
  (:action do-roll
    :parameters (?x - part)
    :precondition (and (not (busy roller)) (not (scheduled ?x)))
    :effect (and (busy roller) (scheduled ?x) (objscheduled)
      (temperature ?x hot) (not (temperature ?x cold)) (shape ?x cylindrical)
      (forall (?s - surface) (not (surface-condition ?x ?s)))
      (forall (?c - colour) (not (painted ?x ?c)))
      (forall (?w - width ?o - anorient) (not (has-hole ?x ?w ?o)))
      (forall (?s - ashape) (when (not (= ?s cylindrical)) (not (shape ?x ?s))))))
  (:action do-lathe
    :parameters (?x - part)
    :precondition (and (not (busy lathe)) (not (scheduled ?x)))
    :effect (and (busy lathe) (scheduled ?x) (objscheduled)
      (surface-condition ?x rough) (shape ?x cylindrical)
      (forall (?s - ashape) (when (not (= ?s cylindrical)) (not (shape ?x ?s))))
      (forall (?s - surface) (when (not (= ?s rough)) (not (surface-condition ?x ?s))))
      (forall (?c - colour) (not (painted ?x ?c)))))
  (:action do-grind
    :parameters (?x - part)
    :precondition (and (not (busy grinder)) (not (scheduled ?x)))
    :effect (and (busy grinder) (scheduled ?x) (objscheduled) (surface-condition ?x smooth)
      (forall (?s - surface) (when (not (= ?s smooth)) (not (surface-condition ?x ?s))))
      (forall (?c - colour) (not (painted ?x ?c)))))
  (:action do-punch
    :parameters (?x - part ?w - width ?o - anorient)
    :precondition (and (has-bit punch ?w) (can-orient punch ?o) (temperature ?x cold)
                       (not (busy punch)) (not (scheduled ?x)) (not (has-hole ?x ?w ?o)))
    :effect (and (busy punch) (scheduled ?x) (objscheduled) (has-hole ?x ?w ?o)
      (surface-condition ?x rough)
      (forall (?s - surface) (when (not (= ?s rough)) (not (surface-condition ?x ?s))))))
  (:action do-drill-press
    :parameters (?x - part ?w - width ?o - anorient)
    :precondition (and (has-bit drill-press ?w) (can-orient drill-press ?o) (temperature ?x cold)
                       (not (busy drill-press)) (not (scheduled ?x)) (not (has-hole ?x ?w ?o)))
    :effect (and (busy drill-press) (scheduled ?x) (objscheduled) (has-hole ?x ?w ?o)))
  (:action do-spray-paint
    :parameters (?x - part ?c - colour)
    :precondition (and (has-paint spray-painter ?c) (temperature ?x cold)
                       (not (busy spray-painter)) (not (scheduled ?x)))
    :effect (and (busy spray-painter) (scheduled ?x) (objscheduled) (painted ?x ?c)
      (forall (?s - surface) (not (surface-condition ?x ?s)))
      (forall (?d - colour) (when (not (= ?d ?c)) (not (painted ?x ?d))))))
  (:action do-immersion-paint
    :parameters (?x - part ?c - colour)
    :precondition (and (has-paint immersion-painter ?c)
                       (not (busy immersion-painter)) (not (scheduled ?x)))
    :effect (and (busy immersion-painter) (scheduled ?x) (objscheduled) (painted ?x ?c)
      (forall (?d - colour) (when (not (= ?d ?c)) (not (painted ?x ?d))))))
  (:action do-time-step
    :precondition (objscheduled)
    :effect (and (forall (?x - part) (not (scheduled ?x)))
                 (forall (?m - machine) (not (busy ?m))))))
