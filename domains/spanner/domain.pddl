; A man collects spanners on a way of no return and tightens nuts at its end.
(define (domain spanner)
  (:requirements :typing)
  (:types location locatable - object  man nut spanner - locatable)
  (:predicates
    (at ?m - locatable ?l - location) (carrying ?m - man ?s - spanner) (useable ?s - spanner)
    (link ?x ?y - location) (tightened ?n - nut) (loose ?n - nut))
  (:action walk
    :parameters (?from ?to - location ?m - man)
    :precondition (and (at ?m ?from) (link ?from ?to))
    :effect (and (not (at ?m ?from)) (at ?m ?to)))
  (:action pickup_spanner
    :parameters (?l - location ?s - spanner ?m - man)
    :precondition (and (at ?m ?l) (at ?s ?l))
    :effect (and (not (at ?s ?l)) (carrying ?m ?s)))
  (:action tighten_nut
    :parameters (?l - location ?s - spanner ?m - man ?n - nut)
    :precondition (and (at ?m ?l) (at ?n ?l) (carrying ?m ?s) (useable ?s) (loose ?n))
    :effect (and (not (loose ?n)) (not (useable ?s)) (tightened ?n))))
