; A robot in a grid, some of whose cells are locked: predicates and actions of the competitions'
; domain of this name.
(define (domain grid)
  (:requirements :strips)
  (:predicates
    (place ?p) (key ?k) (shape ?s) (conn ?x ?y) (key-shape ?k ?s) (lock-shape ?x ?s)
    (at ?k ?x) (at-robot ?x) (locked ?x) (open ?x) (holding ?k) (arm-empty))
  (:action unlock
    :parameters (?here ?there ?k ?s)
    :precondition (and (place ?here) (place ?there) (key ?k) (shape ?s) (conn ?here ?there)
                       (key-shape ?k ?s) (lock-shape ?there ?s)
                       (at-robot ?here) (locked ?there) (holding ?k))
    :effect (and (open ?there) (not (locked ?there))))
  (:action move
    :parameters (?here ?there)
    :precondition (and (place ?here) (place ?there) (conn ?here ?there)
                       (at-robot ?here) (open ?there))
    :effect (and (not (at-robot ?here)) (at-robot ?there)))
  (:action pickup
    :parameters (?here ?k)
    :precondition (and (place ?here) (key ?k) (at-robot ?here) (at ?k ?here) (arm-empty))
    :effect (and (holding ?k) (not (at ?k ?here)) (not (arm-empty))))
  (:action pickup-and-loose
    :parameters (?here ?new ?old)
    :precondition (and (place ?here) (key ?new) (key ?old)
                       (at-robot ?here) (holding ?old) (at ?new ?here))
    :effect (and (holding ?new) (at ?old ?here) (not (holding ?old)) (not (at ?new ?here))))
  (:action putdown
    :parameters (?here ?k)
    :precondition (and (place ?here) (key ?k) (at-robot ?here) (holding ?k))
    :effect (and (arm-empty) (at ?k ?here) (not (holding ?k)))))
